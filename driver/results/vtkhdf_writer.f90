module vtkhdf_writer
  !! results.vtkhdf: all outputs of a run in one HDF5 file with two top-level groups.
  !!
  !! /VTKHDF is what ParaView reads (unstructured grid, version 2.0): the mesh once, fields appended step by step.
  !! RationalWeights become active by themselves in VTK 9.7 and later, through the attribute `Attribute`; older
  !! versions show the .vtu files right.
  !!
  !! /bezel is the program's own: `mesh` (nodes, weights, extraction), `steps`, `displacement` (control values at each
  !! output) and `provenance` (texts).
  !!
  !! The file is closed after each output. While it is open a file NAME.open lies beside it: if that is found at a
  !! restart, the run was killed in between, the file cannot be trusted, and it is written anew from the .vtu files.
  use kinds, only: wp, i8
  use hdf5_store, only: hdf5_store_type
  use byte_file, only: byte_file_type
  use file_system, only: file_exists, remove_file
  use extraction_set, only: extraction_set_type
  use bezier_cells, only: bezier_cells_type
  use result_frame, only: result_frame_type, named_text_type
  implicit none (type, external)
  private
  public :: create_vtkhdf, append_vtkhdf, resume_vtkhdf, vtkhdf_is_sound

  character(*), parameter :: vtk = '/VTKHDF', steps = '/VTKHDF/Steps'

contains

  subroutine create_vtkhdf(path, cells, mesh, x, w, provenance, message)
    !! A new file with the mesh and no step.
    character(*), intent(in) :: path
    type(bezier_cells_type), intent(in) :: cells
    type(extraction_set_type), intent(in) :: mesh
    real(wp), contiguous, intent(in) :: x(:, :)                         !! control points (ndm,nn) [length]
    real(wp), contiguous, intent(in) :: w(:)                            !! control weights (nn)
    type(named_text_type), intent(in) :: provenance(:)      !! deck text, parameters, version, compiler, ...
    character(:), allocatable, intent(out) :: message       !! what failed, unallocated when all is well

    type(hdf5_store_type) :: store
    integer, allocatable :: degrees(:, :)
    integer :: k, ne, last

    call store%create_draft(path)
    call store%make_group(vtk)
    call store%write_attribute(vtk, 'Version', [2_i8, 0_i8])
    call store%write_attribute(vtk, 'Type', 'UnstructuredGrid')
    call store%append(vtk//'/NumberOfPoints', [int(cells%np, i8)])
    call store%append(vtk//'/NumberOfCells', [int(cells%nc, i8)])
    call store%append(vtk//'/NumberOfConnectivityIds', [int(cells%np, i8)])
    call store%append(vtk//'/Points', cells%points)
    call store%append(vtk//'/Connectivity', cells%connectivity)
    call store%append(vtk//'/Offsets', cells%offsets)
    call store%append(vtk//'/Types', cells%types)
    call store%append(vtk//'/PointData/RationalWeights', cells%weights)
    call store%write_attribute(vtk//'/PointData/RationalWeights', 'Attribute', 'RationalWeights')
    call store%append(vtk//'/CellData/HigherOrderDegrees', cells%degrees)
    call store%write_attribute(vtk//'/CellData/HigherOrderDegrees', 'Attribute', 'HigherOrderDegrees')
    call store%append(vtk//'/CellData/material', cells%material)
    call store%append(vtk//'/CellData/body', cells%body)
    call store%make_group(steps)
    call store%write_attribute(steps, 'NSteps', 0_i8)

    ne = mesh%ne
    last = mesh%node_ptr(ne+1) - 1
    degrees = mesh%degree(:, :ne)
    call store%write('/bezel/mesh/nodes', x)
    call store%write('/bezel/mesh/weights', w)
    call store%write('/bezel/mesh/dimension', mesh%dp(:ne))
    call store%write('/bezel/mesh/degree', degrees)
    call store%write('/bezel/mesh/connectivity_start', mesh%node_ptr(:ne+1))
    call store%write('/bezel/mesh/connectivity', mesh%nodes(:last))
    call store%write('/bezel/mesh/operator_of', mesh%operator_of(:ne))
    call store%write('/bezel/mesh/operator_rows', mesh%op_rows(:mesh%nop))
    call store%write('/bezel/mesh/operator_columns', mesh%op_columns(:mesh%nop))
    call store%write('/bezel/mesh/operator_start', mesh%op_ptr(:mesh%nop+1))
    call store%write('/bezel/mesh/operators', mesh%coef(:mesh%op_ptr(mesh%nop+1)-1))
    call store%write('/bezel/mesh/material', cells%material)
    call store%write('/bezel/mesh/body', cells%body)
    call store%make_group('/bezel/provenance')
    do k = 1, size(provenance)
      call store%write_text('/bezel/provenance/'//provenance(k)%name, provenance(k)%text)
    end do
    call store%publish()
    if (store%failed) message = store%message
  end subroutine create_vtkhdf

  subroutine append_vtkhdf(path, cells, frame, message)
    !! One output. The names and sizes of fields are those of the first.
    character(*), intent(in) :: path
    type(bezier_cells_type), intent(in) :: cells
    type(result_frame_type), intent(in) :: frame
    character(:), allocatable, intent(out) :: message    !! what failed, unallocated when all is well

    type(hdf5_store_type) :: store
    type(byte_file_type) :: sign
    integer(i8) :: n, before
    integer :: k

    call sign%create(path//'.open')
    call sign%close()
    if (sign%failed) then
      message = sign%message
      return
    end if
    call store%open_to_write(path)
    n = store%length('/bezel/steps/step')
    before = n*cells%np
    if (.not. store%has('/bezel/steps/fields')) call store%write_text('/bezel/steps/fields', names_of(frame))
    call store%append('/bezel/steps/step', [frame%step])
    call store%append('/bezel/steps/time', [frame%time])
    call store%append('/bezel/displacement', reshape(frame%u, [size(frame%u, 1), size(frame%u, 2), 1]))

    ! the mesh stands: every step shows the first part
    call store%append(steps//'/Values', [frame%time])
    call store%append(steps//'/PartOffsets', [0_i8])
    call store%append(steps//'/NumberOfParts', [1_i8])
    call store%append(steps//'/PointOffsets', [0_i8])
    call store%append(steps//'/CellOffsets', reshape([0_i8], [1, 1]))
    call store%append(steps//'/ConnectivityIdOffsets', reshape([0_i8], [1, 1]))
    call store%append(steps//'/PointDataOffsets/RationalWeights', [0_i8])
    call store%append(steps//'/CellDataOffsets/HigherOrderDegrees', [0_i8])
    call store%append(steps//'/CellDataOffsets/material', [0_i8])
    call store%append(steps//'/CellDataOffsets/body', [0_i8])
    do k = 1, size(frame%fields)
      call store%append(steps//'/PointDataOffsets/'//frame%fields(k)%name, [before])
      if (size(frame%fields(k)%values, 1) == 1) then
        call store%append(vtk//'/PointData/'//frame%fields(k)%name, reshape(frame%fields(k)%values, [cells%np]))
      else
        call store%append(vtk//'/PointData/'//frame%fields(k)%name, frame%fields(k)%values)
      end if
    end do
    call store%write_attribute(steps, 'NSteps', n + 1)
    call finish(store, path, message)
  end subroutine append_vtkhdf

  pure function names_of(frame) result(names)
    type(result_frame_type), intent(in) :: frame
    character(:), allocatable :: names    !! of the fields, each followed by a line feed

    integer :: k

    names = ''
    do k = 1, size(frame%fields)
      names = names//frame%fields(k)%name//new_line('a')
    end do
  end function names_of

  logical function vtkhdf_is_sound(path)
    !! Whether the file is there and was closed after its last output.
    character(*), intent(in) :: path

    type(hdf5_store_type) :: store

    vtkhdf_is_sound = .false.
    if (file_exists(path//'.open')) return
    if (.not. file_exists(path)) return
    call store%open_to_read(path)
    if (store%has(steps)) vtkhdf_is_sound = store%has('/bezel/mesh')
    call store%close()
  end function vtkhdf_is_sound

  subroutine resume_vtkhdf(path, cells, step, message)
    !! Forget the outputs after a step.
    character(*), intent(in) :: path
    type(bezier_cells_type), intent(in) :: cells
    integer, intent(in) :: step
    character(:), allocatable, intent(out) :: message    !! what failed, unallocated when all is well

    character(48), parameter :: series(13) = [character(48) :: '/bezel/steps/step', '/bezel/steps/time', &
      '/bezel/displacement', steps//'/Values', steps//'/PartOffsets', steps//'/NumberOfParts', steps//'/PointOffsets', &
      steps//'/CellOffsets', steps//'/ConnectivityIdOffsets', &
      steps//'/PointDataOffsets/RationalWeights', steps//'/CellDataOffsets/HigherOrderDegrees', &
      steps//'/CellDataOffsets/material', steps//'/CellDataOffsets/body']
    type(hdf5_store_type) :: store
    type(byte_file_type) :: sign
    character(:), allocatable :: names
    integer, allocatable :: number(:)
    integer(i8) :: n
    integer :: k, from, last

    call sign%create(path//'.open')
    call sign%close()
    if (sign%failed) then
      message = sign%message
      return
    end if
    call store%open_to_write(path)
    if (store%has('/bezel/steps/step')) then
      call store%read('/bezel/steps/step', number)
      n = count(number <= step)
      if (n < size(number)) then
        do k = 1, size(series)
          call store%set_length(trim(series(k)), n)
        end do
        call store%read_text('/bezel/steps/fields', names)
        from = 1
        do while (from < len(names))
          last = from + index(names(from:), new_line('a')) - 2
          call store%set_length(steps//'/PointDataOffsets/'//names(from:last), n)
          call store%set_length(vtk//'/PointData/'//names(from:last), n*cells%np)
          from = last + 2
        end do
        call store%write_attribute(steps, 'NSteps', n)
      end if
    end if
    call finish(store, path, message)
  end subroutine resume_vtkhdf

  subroutine finish(store, path, message)
    !! Only a file that was closed without failure loses the sign that it is open.
    type(hdf5_store_type), intent(inout) :: store
    character(*), intent(in) :: path
    character(:), allocatable, intent(inout) :: message

    call store%close()
    if (store%failed) then
      message = store%message
    else if (.not. remove_file(path//'.open')) then
      message = 'cannot remove '//path//'.open'
    end if
  end subroutine finish
end module vtkhdf_writer
