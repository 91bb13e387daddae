module model_summary
  !! What a model holds, for --check: counts, bodies with their area or volume, sets, materials,
  !! interfaces.
  use kinds, only: wp
  use status_codes, only: ok
  use extraction_set, only: extraction_set_type
  use number_text, only: write_number
  use messages, only: whole_text
  use model_data, only: model_type, set_nodes, set_elements, set_surface
  use model_sets, only: used_nodes, nodes_of_set
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use surface_frame, only: tangent_frame_at
  implicit none (type, external)
  private
  public :: describe_model, degrees_text, element_measure

contains

  subroutine describe_model(model, unit)
    type(model_type), intent(in), target :: model
    integer, intent(in) :: unit                      !! where to print
    logical, allocatable :: used(:)
    integer, allocatable :: nodes(:)
    character(:), allocatable :: size_text
    integer :: a, i, e

    call used_nodes(model, used)
    write (unit, '(a)') 'title       ' // trim(adjustl(model%title))
    write (unit, '(a,i0,a,i0)') 'space       ndm ', model%ndm, ', ndf ', model%ndf
    write (unit, '(a,i0,a,i0,a)') 'nodes       ', count(used), ' (', size(used) - count(used), &
      ' unused)'
    write (unit, '(a,i0,a,i0,a,i0,a)') 'dofs        ', model%ndf*count(used), ' (', &
      count([(.not. model%fixed(:, a) .and. used(a), a = 1, model%nn)]), ' free, ', &
      size(model%links), ' linked)'
    write (unit, '(a,i0,a,i0,a)') 'elements    ', model%mesh%ne, ' (', model%mesh%nop, &
      ' different operators)'
    write (unit, '(a,i0,a,i0)') 'functions   per element ', minval([(model%mesh%nen(e), e = 1, &
      model%mesh%ne)]), &
      ' to ', maxval([(model%mesh%nen(e), e = 1, model%mesh%ne)])
    write (unit, '(a)') 'degrees     ' // degrees_text(model%mesh)
    do i = 1, maxval(model%body_of)
      if (any(model%body_of == i)) call describe_body(model, i, unit)
    end do
    do i = 1, size(model%materials)
      write (unit, '(a,i0,1x,a,i0,a)') 'material    ', model%materials(i)%number, &
        model%materials(i)%name // ' ', &
        count(model%material_of == i), ' elements'
    end do
    size_text = ''
    do i = 1, size(model%sets)
      associate (set => model%sets(i))
        nodes = nodes_of_set(model, i)
        select case (set%kind)
        case (set_nodes);    size_text = ''
        case (set_elements); size_text = whole_text(size(set%items)) // ' elements, '
        case (set_surface);  size_text = whole_text(size(set%items)) // ' facets, '
        end select
        write (unit, '(a)') 'set         ' // set%name // ': ' // size_text // &
          whole_text(size(nodes)) // ' nodes'
      end associate
    end do
    do i = 1, size(model%interfaces)
      associate (pair => model%interfaces(i))
        write (unit, '(a)') 'interface   ' // pair%name // ': slave ' // &
          model%sets(pair%slave)%name // ', master ' // &
          model%sets(pair%master)%name // ', ' // whole_text(pair%gp) // &
          ' Gauss points per direction'
      end associate
    end do
    do i = 1, size(model%end_faces)
      associate (face => model%end_faces(i))
        write (unit, '(a)') 'end face    ' // face%name // ': ' // model%sets(face%set)%name // &
          trim(merge(', free to warp', ', rigid       ', face%warps)) // &
          merge(', rotation prescribed', ', moment given       ', model%fixed(1, face%rotation))
      end associate
    end do
    do i = 1, size(model%loads)
      write (unit, '(a)') 'load        ' // trim(model%loads(i)%kind) // ' on ' // &
        model%sets(model%loads(i)%set)%name
    end do
  end subroutine describe_model

  subroutine describe_body(model, body, unit)
    type(model_type), intent(in) :: model
    integer, intent(in) :: body, unit
    real(wp) :: total
    integer :: e, dp

    total = 0
    dp = 0
    do e = 1, model%mesh%ne
      if (model%body_of(e) /= body) cycle
      total = total + element_measure(model, e)
      dp = model%mesh%dp(e)
    end do
    write (unit, '(a,i0,a,i0,a)') 'body        ', body, ': ', count(model%body_of == body), &
      ' elements, ' // &
      trim(merge('volume', merge('area  ', 'length', dp == 2), dp == 3)) // ' ' // &
      write_number(total)
  end subroutine describe_body

  function element_measure(model, e) result(total)
    !! Length, area or volume of an element in the reference configuration. The rule is exact for
    !! polynomial maps.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: e
    real(wp) :: total
    real(wp), allocatable :: xe(:, :), we(:), ce(:, :), shp(:), dshp(:, :), d2shp(:, :), &
      dshpx(:, :), xi(:, :), wt(:)
    integer, allocatable :: ix(:)
    real(wp) :: j, x(model%ndm), tau(model%ndm, model%ndm - 1), nrm(model%ndm)
    integer :: dp, g, nen, ng, status

    dp = model%mesh%dp(e)
    nen = model%mesh%nen(e)
    allocate (ix, source=model%mesh%nodes(model%mesh%node_ptr(e):model%mesh%node_ptr(e + 1) - 1))
    allocate (ce, source=model%mesh%operator(e))
    xe = model%x(:, ix)
    we = model%w(ix)
    allocate (shp(nen), dshp(dp, nen), d2shp((dp*(dp + 1))/2, nen), dshpx(dp, nen))
    ng = product(model%mesh%degree(1:dp, e) + 4)
    allocate (xi(dp, ng), wt(ng))
    call tensor_rule(model%mesh%degree(1:dp, e) + 4, xi, wt)
    total = 0
    do g = 1, ng
      call shape_functions(model%mesh%degree(1:dp, e), we, ce, xi(:, g), 1, shp, dshp, d2shp, &
        status)
      if (status /= ok) return
      if (dp == model%ndm) then
        call physical_gradient(xe, dshp, dshpx, j, status)
      else
        call tangent_frame_at(xe, shp, dshp, x, tau, nrm, j, status)
      end if
      total = total + wt(g)*j
    end do
  end function element_measure

  function degrees_text(mesh) result(text)
    !! The different degrees, with the number of their elements.
    type(extraction_set_type), intent(in) :: mesh
    character(:), allocatable :: text
    integer, allocatable :: code(:)
    integer :: e, i, first

    allocate (code(mesh%ne))
    do e = 1, mesh%ne
      code(e) = dot_product([1000000, 1000, 1], mesh%degree(:, e))
    end do
    text = ''
    do
      first = findloc(code >= 0, .true., dim=1)
      if (first == 0) exit
      if (len(text) > 0) text = text // ', '
      do i = 1, mesh%dp(first)
        if (i > 1) text = text // ' x '
        text = text // whole_text(mesh%degree(i, first))
      end do
      i = code(first)
      text = text // ' (' // whole_text(count(code == i)) // ' elements)'
      where (code == i) code = -1
    end do
  end function degrees_text
end module model_summary
