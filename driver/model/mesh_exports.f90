module mesh_exports
  !! The mesh of a model as EXPOrt writes it: nodes and elements keep their numbers (less one in
  !! `.iga`), sets their names.
  use kinds, only: wp
  use messages, only: message_log
  use model_data, only: model_type, set_nodes, set_elements
  use extraction_mesh, only: extraction_mesh_type, problem_list, set_of_nodes, set_of_elements, &
    set_of_sides
  use iga_writer, only: write_iga, iga_problems
  use mesh_store, only: write_mesh_store
  use byte_file, only: byte_file_type
  use result_folder, only: result_folder_type
  implicit none (type, external)
  private
  public :: check_exports, write_exports, mesh_of_model

contains

  subroutine mesh_of_model(model, mesh)
    type(model_type), intent(in) :: model
    type(extraction_mesh_type), intent(inout) :: mesh
    integer :: i, kind

    call mesh%start('')
    mesh%nn = model%nn
    deallocate (mesh%x, mesh%w, mesh%node_line, mesh%element_line)
    allocate (mesh%x(3, model%nn), source=0.0_wp)
    mesh%x(1:model%ndm, :) = model%x(1:model%ndm, 1:model%nn)
    mesh%w = model%w(1:model%nn)
    allocate (mesh%node_line(model%nn), mesh%element_line(model%mesh%ne), source=0)
    mesh%elements = model%mesh
    do i = 1, size(model%sets)
      associate (set => model%sets(i))
        kind = set_of_sides
        if (set%kind == set_nodes) kind = set_of_nodes
        if (set%kind == set_elements) kind = set_of_elements
        call mesh%add_set(set%name, kind, 0, set%items, set%sides)
      end associate
    end do
  end subroutine mesh_of_model

  subroutine check_exports(model, log)
    !! Before anything is run: can the formats hold the mesh?
    type(model_type), intent(in) :: model
    type(message_log), intent(inout) :: log
    type(extraction_mesh_type) :: mesh
    type(problem_list) :: problems
    integer :: i, k

    if (.not. any(model%exports%is_text)) return
    call mesh_of_model(model, mesh)
    call iga_problems(mesh, problems)
    do i = 1, size(model%exports)
      if (.not. model%exports(i)%is_text) cycle
      do k = 1, problems%kept
        call log%add_error(model%exports(i)%at, 'EXPOrt', problems%list(k)%fact, &
          problems%list(k)%remedy)
      end do
    end do
  end subroutine check_exports

  subroutine write_exports(model, folder, message)
    type(model_type), intent(in) :: model
    type(result_folder_type), intent(inout) :: folder
    character(:), allocatable, intent(out) :: message    !! allocated if a file failed
    type(extraction_mesh_type) :: mesh
    type(byte_file_type) :: out
    character(:), allocatable :: text
    integer :: i

    if (size(model%exports) == 0) return
    call mesh_of_model(model, mesh)
    do i = 1, size(model%exports)
      associate (export => model%exports(i))
        if (export%is_text) then
          call write_iga(mesh, model%ndm, text)
          call out%create_draft(folder%file(export%file))
          call out%put_text(text)
          call out%publish()
          if (out%failed) message = out%message
        else
          call write_mesh_store(folder%file(export%file), mesh, message)
        end if
      end associate
      if (allocated(message)) return
    end do
  end subroutine write_exports
end module mesh_exports
